"""Speed beside other libraries: `python -m validation.benchmarks.peers`."""
