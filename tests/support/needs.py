"""Marks of tests that need what pip does not install; a skip names the packages."""

from __future__ import annotations

import emf_check
import pytest

EMF = pytest.mark.skipif(bool(emf_check.missing()), reason=emf_check.missing() or "EMF is there")
