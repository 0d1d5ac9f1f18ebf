A JAUS engineer has a service in JSIDL, and wants a component that speaks it.

<< Boom.xml
<?xml version="1.0" encoding="UTF-8"?>
<service_def xmlns="urn:jaus:jsidl:1.0" name="Boom" id="urn:agro:jaus:Boom" version="1.0">
  <description>Folds and unfolds a boom.</description>
  <references><inherits_from name="management" id="urn:jaus:jss:core:Management" version="1.1"/></references>
  <declared_type_set name="Types"/>
  <message_set>
    <input_set>
      <message_def name="FoldBoom" message_id="D101" is_command="true"><body name="Body"/></message_def>
      <message_def name="QueryBoom" message_id="D102" is_command="false"><body name="Body"/></message_def>
    </input_set>
    <output_set>
      <message_def name="ReportBoom" message_id="D103" is_command="false">
        <body name="Body"><record name="Rec" optional="false">
          <fixed_field name="State" field_type="unsigned byte" field_units="one" optional="false">
            <value_set offset_to_lower_limit="false">
              <value_enum enum_index="0" enum_const="folded"/>
              <value_enum enum_index="1" enum_const="moving"/>
            </value_set>
          </fixed_field>
        </record></body>
      </message_def>
    </output_set>
  </message_set>
  <internal_events_set/>
  <protocol_behavior is_stateless="false">
    <start state_machine_name="Folding" state_name="Folded"/>
    <state_machine name="Folding">
      <state name="Folded">
        <transition name="management.accessControl.events.transport.Receive">
          <parameter type="FoldBoom" value="msg"/>
          <simple><end_state state="Moving"/></simple>
        </transition>
      </state>
      <state name="Moving">
        <entry><action name="startMotor"/></entry>
        <exit><action name="stopMotor"/></exit>
      </state>
      <default_state>
        <transition name="management.accessControl.events.transport.Receive">
          <parameter type="QueryBoom" value="msg"/>
          <parameter type="Receive.Body.ReceiveRec" value="transportData"/>
          <simple/>
          <action name="management.accessControl.events.transport.Send">
            <argument value="'ReportBoom'"/><argument value="transportData"/>
          </action>
        </transition>
      </default_state>
    </state_machine>
  </protocol_behavior>
</service_def>
>>

$ jausml init farm --from empty --notation {NOTATION}
> cd farm

$ cd farm && git init -q && jausml import jsidl ../Boom.xml -o models/
> info: JML629 the transition leaves and enters no state: 'Moving' keeps what it does
> models/agro.xmi: 1 set, 1 service, 3 messages, written

$ cd farm && jausml new component boom --address 100.1.1 --provides Boom
> models/farm.{SUFFIX} written
> next: jausml validate models/farm.{SUFFIX}

$ cd farm && jausml validate --strict
> no problems

$ cd farm && jausml generate -o ws
> created

The skeleton is filled in: a motor, and a report of the state.

$ cd farm && python {STORIES}/fill_boom.py ws/boom/boom/boom.py
$ cd farm && PYTHONPATH=$(printf '%s:' ws/*/) python -m pytest -q -p no:cacheprovider ws/boom/test
> passed

& bash -c 'cd farm && exec jausml run ws'
> boom runs as 100.1.1

A query does not stop the motor, and tells the state.

$ cd farm && jausml ocu query 100.1.1 QueryBoom
> ReportBoom  State=0 (folded)
$ cd farm && jausml ocu request 100.1.1 FoldBoom
> 100.1.1 is in READY
$ cd farm && jausml ocu query 100.1.1 QueryBoom && jausml ocu query 100.1.1 QueryBoom
> ReportBoom  State=1 (moving)
> ReportBoom  State=1 (moving)
$ test "$(cat farm/motor.log)" = start

The next version of the service has another name for a value. What that breaks is known at once, and mended.

$ cd farm && sed s/moving/running/ ../Boom.xml > ../Next.xml && jausml import jsidl ../Next.xml -o models/ --force
> models/agro.xmi: 1 set, 1 service, 3 messages, written
$ cd farm && jausml generate -o ws
! 1
> error: JML906 ReportBoom.State has no MOVING any more; it is RUNNING now
> --fix changes your files
$ cd farm && jausml generate -o ws --check --strict
! 1
> error: JML906 ReportBoom.State has no MOVING any more
$ cd farm && jausml generate -o ws --fix
> fixed: MOVING -> RUNNING
$ cd farm && jausml generate -o ws --check --strict
$ cd farm && PYTHONPATH=$(printf '%s:' ws/*/) python -m pytest -q -p no:cacheprovider ws/boom/test
> passed
