A ROS developer has a robot that nobody has described, and lets a JAUS operator use it.

& python {STORIES}/robot.py
> ready

$ jausml init abyss --from empty --notation {NOTATION}
> cd abyss

$ cd abyss && git init -q && jausml new bridge abyss --from-graph --for 60 --yes
> /joint_states names the joints shoulder, elbow, wrist
> left out: service drop_weight: no type says which JAUS message asks; next: jausml new service-connection
> imu/data: ROS -> JAUS, global_pose: read as imu with fix
> models/abyss.{SUFFIX} written

$ cd abyss && jausml new service Dropper --message DropWeight --message ConfirmDrop --message RejectDrop
> DropWeight
> written

$ cd abyss && jausml new service-connection drop_weight:std_srvs/Trigger DropWeight
> DropWeight calls it; answered by ConfirmDrop or RejectDrop
> written

$ cd abyss && jausml validate --strict
> no problems
$ cd abyss && jausml generate -o ws
> created

& bash -c 'cd abyss && exec jausml run ws'
> runs as 100.1.1

An operator finds it, looks at it, and drops the weight.

$ cd abyss && jausml ocu discover
> 100.1.1
$ cd abyss && jausml ocu query 100.1.1 QueryLocalPose
> ReportLocalPose
$ cd abyss && jausml ocu query 100.1.1 QueryJointPositions
> JointPosition=0.25000000 rad
> JointPosition=-0.50000000 rad
$ cd abyss && jausml ocu request 100.1.1 DropWeight
> ConfirmDrop
$ cd abyss && jausml ocu request 100.1.1 DropWieght
! 2
> did you mean DropWeight?

What no tool can know is open, and an error where a meaning hangs on it, until a person has decided it.

$ cd abyss && jausml new map teleop SetVelocityCommand geometry_msgs/Twist --direction to-jaus --fill --yes
> CommandType takes "Set current command", the first of 4 that fit (JML498, blocking)
$ cd abyss && jausml generate -o ws
! 1
> error: JML498 open in 'teleop': CommandType takes
> nothing generated
$ cd abyss && jausml new --open
> (decide it, then remove the open decision)
> 1 error
$ cd abyss && sed -i.orig /openDecisions/d models/abyss.{SUFFIX} && jausml new --open
> nothing is open

The robot has a message type of its own, too.

<< abyss_msgs/msg/Tank.msg
float32 level # [%]
float32 temperature # [degC]
>>
<< abyss_msgs/package.xml
<package format="3"><name>abyss_msgs</name><version>1.0.0</version><description>Tanks.</description>
<maintainer email="x@example.org">x</maintainer><license>MIT</license></package>
>>

$ cd abyss && jausml new map tank ReportTank abyss_msgs/Tank
! 2
> 'jausml new service' makes messages, 'jausml import jsidl' reads them
<< abyss/models/tanks.ros2jaus
import `jaus.core-1.1`
service_set abyss {
    service Tanks {
        urn: "urn:example:abyss:Tanks"
        inherits: Events
        inputs: new message_def QueryTank { code: 0xD301 }
        outputs: new message_def ReportTank {
            code: 0xD501
            record TankRec {
                fixed_field Level { type: uint16  units: "percent"  scale: { lower: 0  upper: 100 } }
                fixed_field Temperature { type: uint16  units: "degC"  scale: { lower: -20  upper: 60 } }
            }
        }
    }
}
>>
$ cd abyss && jausml new map tank ReportTank abyss_msgs/Tank
! 2
> jausml import ros
$ cd abyss && jausml import ros ../abyss_msgs -o models/
> models/abyss_msgs.xmi: 1 package, 1 message
$ cd abyss && jausml new map tank ReportTank abyss_msgs/Tank --yes
> level -> Level
> state freshness, or whenStale: keep, for a topic that falls silent (JML455)
$ cd abyss && jausml new connection tank:abyss_msgs/Tank --yes
> tank: ROS -> JAUS, tank: reported as ReportTank of Tanks to whoever asks
$ cd abyss && jausml validate
> JML455 'tank' reports the last message of its topic forever
> 1 warning
$ cd abyss && jausml doctor
! 1
> abyss_msgs: Python finds no such package of messages
> colcon build it
$ cd abyss && jausml generate -o ws && jausml run ws
! 2
> abyss_msgs
> colcon build
