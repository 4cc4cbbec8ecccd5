"""GPU kernels checked and measured on a device:  python -m validation.benchmarks.gpu

correctness   every term of six robots in both types against the host's kernels, up to a million states
throughput    samples a second, data on the device, and with copies from and to the host
peers         other libraries that compute the same, checked to be equal before and after they are measured
page          the results as Markdown
"""
