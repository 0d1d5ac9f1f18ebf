#!/bin/sh
# pyecoregen 0.5.1 (pyecore 0.15.2): classes generated from an Ecore model have other bounds and other
# numbers of literals.
#
# - Each upper bound but 1 becomes -1 (no bound) and each lower bound 0: what has one wheel to four has
#   any number of them, and who counts by the generated classes what is missing finds nothing.
# - The literals of an enumeration are numbered from 0 by their order, whatever their values are, and
#   lose the texts (`literal`) by which EMF writes them into XMI.
# Defaults and ids survive.
#
# Seen: the lines below EXPECTED: of the model that was read, and of the generated classes.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
python3 -m venv "$folder/venv"
"$folder/venv/bin/pip" install --quiet pyecore==0.15.2 pyecoregen==0.5.1

cat > "$folder/fleet.ecore" <<'ECORE'
<?xml version="1.0" encoding="UTF-8"?>
<ecore:EPackage xmi:version="2.0" xmlns:xmi="http://www.omg.org/XMI"
    xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"
    xmlns:ecore="http://www.eclipse.org/emf/2002/Ecore"
    name="fleet" nsURI="http://example.org/fleet" nsPrefix="fleet">
  <eClassifiers xsi:type="ecore:EEnum" name="Mode">
    <eLiterals name="STANDBY" value="3" literal="stand by"/>
    <eLiterals name="READY" value="5"/>
  </eClassifiers>
  <eClassifiers xsi:type="ecore:EClass" name="Vehicle">
    <eStructuralFeatures xsi:type="ecore:EAttribute" name="number" lowerBound="1" iD="true"
        eType="ecore:EDataType http://www.eclipse.org/emf/2002/Ecore#//EString"/>
    <eStructuralFeatures xsi:type="ecore:EAttribute" name="mode" eType="#//Mode"
        defaultValueLiteral="READY"/>
    <eStructuralFeatures xsi:type="ecore:EAttribute" name="speed" defaultValueLiteral="2.5"
        eType="ecore:EDataType http://www.eclipse.org/emf/2002/Ecore#//EDouble"/>
    <eStructuralFeatures xsi:type="ecore:EReference" name="wheels" lowerBound="1" upperBound="4"
        eType="#//Wheel" containment="true"/>
  </eClassifiers>
  <eClassifiers xsi:type="ecore:EClass" name="Wheel"/>
</ecore:EPackage>
ECORE

cat > "$folder/compared.py" <<'PYTHON'
from pyecore.resources import ResourceSet
from pyecoregen.ecore import EcoreGenerator

package = ResourceSet().get_resource("fleet.ecore").contents[0]
EcoreGenerator().generate(package, ".")
import fleet  # noqa: E402 - generated above

literals = [
    ", ".join(f"{literal.name} {literal.value} {literal.literal!r}" for literal in mode.eLiterals)
    for mode in (package.getEClassifier("Mode"), fleet.Mode)
]
print("literals", *literals, sep=" | ")
vehicles = package.getEClassifier("Vehicle"), fleet.Vehicle.eClass
for name in ("number", "mode", "speed", "wheels"):
    features = [vehicle.findEStructuralFeature(name) for vehicle in vehicles]
    print(name, *(f"{feature.lower}..{feature.upper}" for feature in features), sep=" | ")
print("id", *(vehicle.findEStructuralFeature("number").iD for vehicle in vehicles), sep=" | ")
elements = package.getEClassifier("Vehicle")(), fleet.Vehicle()
for name in ("mode", "speed"):
    print("default", name, *(getattr(element, name) for element in elements), sep=" | ")
PYTHON

cat > "$folder/expected" <<'EXPECTED'
literals | STANDBY 3 'stand by', READY 5 None | STANDBY 0 None, READY 1 None
number | 1..1 | 0..1
mode | 0..1 | 0..1
speed | 0..1 | 0..1
wheels | 1..4 | 0..-1
id | True | True
default | mode | READY | READY
default | speed | 2.5 | 2.5
EXPECTED
(cd "$folder" && venv/bin/python compared.py) > "$folder/seen"
cat "$folder/seen"
diff "$folder/expected" "$folder/seen"
