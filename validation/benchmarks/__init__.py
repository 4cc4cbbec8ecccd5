"""Speed beside Pinocchio, measured and written down."""
