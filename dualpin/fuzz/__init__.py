"""Random robots: terms compared with Pinocchio and checked by identities; differences are minimised.

seed -> generate -> examine -> shrink -> a table of kinds, and a minimal robot of each
"""

from .examine import examine
from .generate import random_spec
from .run import Outcome, fuzz
from .shrink import shrink
from .spec import JointSpec, Spec

__all__ = ["JointSpec", "Outcome", "Spec", "examine", "fuzz", "random_spec", "shrink"]
