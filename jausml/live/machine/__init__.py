"""Machines that are to run bridges and components: what one lacks, and how to fix it."""
