A team keeps a model in git, converts it, and deploys it.

$ jausml init rover --from topics fix:sensor_msgs/NavSatFix imu:sensor_msgs/Imu cmd_vel:geometry_msgs/Twist --notation {NOTATION} --yes
> cd rover
$ cd rover && jausml validate --strict
> no problems
$ cat rover/.gitattributes
> *.ros2jaus merge=jausml diff=jausml

Two branches change one connection each, and the merge goes by elements.

$ cd rover && git init -q -b main && git config user.name x && git config user.email x@example.org
$ cd rover && git config merge.jausml.driver "jausml merge --as %P --output %A %O %A %B" && git add . && git commit -qm base
$ cd rover && git checkout -q -b rate && sed -i.orig 's/100.1.1\b/100.1.7/' models/rover.{SUFFIX} && git commit -qam rate
$ cd rover && git checkout -q -b topic main && sed -i.orig 's/cmd_vel/drive/' models/rover.{SUFFIX} && git commit -qam topic
$ cd rover && git merge -q --no-edit rate
$ grep -q 100.1.7 rover/models/rover.{SUFFIX} && grep -q drive rover/models/rover.{SUFFIX}
$ cd rover && jausml validate --strict
> no problems

A conflict that somebody forgot is one error.

$ cd rover && cp models/rover.{SUFFIX} kept && printf '<<<<<<< ours\n=======\n>>>>>>> theirs\n' >> models/rover.{SUFFIX}
$ cd rover && jausml validate models/rover.{SUFFIX}
! 1
> JML009 an unmerged conflict stands in lines
> 1 error in
$ cd rover && mv kept models/rover.{SUFFIX}

The model in the other notation means the same, joins and all.

$ cd rover && jausml convert models/rover.{SUFFIX} ../other.xmi
$ jausml validate other.xmi --strict
> no problems

What was written is what is generated, and CI says so.

$ cd rover && jausml generate -o ws
> created
$ cd rover && jausml generate -o ws --check --strict
