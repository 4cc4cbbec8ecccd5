"""`python -m dualpin` is the same as `dualpin`."""

from .cli import main

if __name__ == "__main__":
    main()
