"""Graphs and schedules: algorithms run on symbols, and the order, chunks and slots of their operations."""
