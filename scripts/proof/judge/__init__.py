"""Judges `ugv diagnose` and its peers on cases with a sealed truth."""
