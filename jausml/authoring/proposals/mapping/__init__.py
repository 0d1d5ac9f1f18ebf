"""Assignments of maps: what corresponds, how one becomes the other, and whether it may."""
