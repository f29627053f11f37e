"""Tests of tester.materials."""
