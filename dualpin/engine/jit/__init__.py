"""From IR to functions in memory: the host, the compiler, the disk cache, kernels, and their calls."""
