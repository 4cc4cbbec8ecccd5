"""Textbook formulations of kinematics and dynamics, written so that one step at a time can be done wrongly."""
