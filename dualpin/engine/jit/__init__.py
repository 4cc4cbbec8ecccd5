"""From IR to functions in memory: the host, the compiler, the disk cache, kernels, and how they are called."""
