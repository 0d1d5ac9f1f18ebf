"""Metamodels: loaded once through pyecore and flattened into tables."""

from jausml.language.metamodel.loading import MetamodelError as MetamodelError
from jausml.language.metamodel.loading import annotation as annotation
from jausml.language.metamodel.loading import documentation as documentation
from jausml.language.metamodel.loading import load_jaus_metamodel as load_jaus_metamodel
from jausml.language.metamodel.loading import load_metamodels as load_metamodels
from jausml.language.metamodel.loading import read_metamodels as read_metamodels
from jausml.language.metamodel.tables import ClassTable as ClassTable
from jausml.language.metamodel.tables import DataTypeTable as DataTypeTable
from jausml.language.metamodel.tables import FeatureKind as FeatureKind
from jausml.language.metamodel.tables import FeatureTable as FeatureTable
from jausml.language.metamodel.tables import Metamodels as Metamodels
from jausml.language.metamodel.tables import PackageTable as PackageTable
from jausml.language.metamodel.tables import ValueKind as ValueKind
