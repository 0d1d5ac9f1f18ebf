"""Texts of two files, of which one refers to the other by positions."""

PACKAGE = """<?xml version="1.0" encoding="UTF-8"?>
<ros:InterfacePackage xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI"
    xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
    xmlns:ros="http://www.jausml.org/ros/1.0" name="d_msgs">
{}</ros:InterfacePackage>
"""
MESSAGE = """  <messages name="{}">
    <fields xsi:type="ros:PrimitiveField" name="x" type="float64"/>
  </messages>
"""
PLANT = """<?xml version="1.0" encoding="UTF-8"?>
<system:System xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI"
    xmlns:ros="http://www.jausml.org/ros/1.0"
    xmlns:system="http://www.jausml.org/system/1.0" name="plant">
{}</system:System>
"""
NODE = """  <nodes name="{}" frequency="{}">
    <publishers topic="t">
      <type href="d_msgs.xmi#//@messages.{}"/>
    </publishers>
  </nodes>
"""
