"""What an engineer must know of a robot before it is built, simulated or identified."""
