"""Analyses of robots: checks, differences, conversion, identification, workspace."""
