"""Tests of tester.inputs.materials."""
