"""The coefficients of every method."""

from __future__ import annotations

from ..errors import ArgumentError, nearest
from .methods import UNBOUNDED, CrouchGrossman, Mechanical, Method, PredictorCorrector, Reference, RungeKutta

EULER = RungeKutta("euler", "explicit Euler", 1, 2.0, "Euler (1768)", A=((),), b=(1.0,))

MIDPOINT = RungeKutta("midpoint", "explicit midpoint", 2, 2.0, "Runge (1895)", A=((), (1 / 2,)), b=(0.0, 1.0))

HEUN = RungeKutta("heun", "Heun", 2, 2.0, "Heun (1900)", A=((), (1.0,)), b=(1 / 2, 1 / 2))

RK4 = RungeKutta(
    "rk4", "classical Runge-Kutta", 4, 2.785293563405282, "Kutta (1901)",
    A=((), (1 / 2,), (0.0, 1 / 2), (0.0, 0.0, 1.0)), b=(1 / 6, 1 / 3, 1 / 3, 1 / 6),
)  # fmt: skip

RKMK4 = RungeKutta(
    "rkmk4", "Runge-Kutta-Munthe-Kaas of order 4", 4, 2.785293563405282, "Munthe-Kaas (1998)", A=RK4.A, b=RK4.b
)

RK45 = RungeKutta(
    "rk45", "Dormand-Prince 5(4), adaptive", 5, 3.306567892634947, "Dormand & Prince (1980); dense: Shampine (1986)",
    A=(
        (),
        (1 / 5,),
        (3 / 40, 9 / 40),
        (44 / 45, -56 / 15, 32 / 9),
        (19372 / 6561, -25360 / 2187, 64448 / 6561, -212 / 729),
        (9017 / 3168, -355 / 33, 46732 / 5247, 49 / 176, -5103 / 18656),
        (35 / 384, 0.0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84),
    ),
    b=(35 / 384, 0.0, 500 / 1113, 125 / 192, -2187 / 6784, 11 / 84, 0.0),
    error=(71 / 57600, 0.0, -71 / 16695, 71 / 1920, -17253 / 339200, 22 / 525, -1 / 40),
    dense=(
        (1.0, -8048581381 / 2820520608, 8663915743 / 2820520608, -12715105075 / 11282082432),
        (0.0, 0.0, 0.0, 0.0),
        (0.0, 131558114200 / 32700410799, -68118460800 / 10900136933, 87487479700 / 32700410799),
        (0.0, -1754552775 / 470086768, 14199869525 / 1410260304, -10690763975 / 1880347072),
        (0.0, 127303824393 / 49829197408, -318862633887 / 49829197408, 701980252875 / 199316789632),
        (0.0, -282668133 / 205662961, 2019193451 / 616988883, -1453857185 / 822651844),
        (0.0, 40617522 / 29380423, -110615467 / 29380423, 69997945 / 29380423),
    ),
)  # fmt: skip

CG3 = CrouchGrossman(
    "crouch_grossman3", "Crouch-Grossman of order 3", 3, 2.5127453266183286, "Crouch & Grossman (1993)",
    A=((), (3 / 4,), (119 / 216, 17 / 108)), b=(13 / 51, -2 / 3, 24 / 17),
)  # fmt: skip

CG4 = CrouchGrossman(
    "crouch_grossman4", "Crouch-Grossman of order 4", 4, 2.332499804007244, "Owren & Marthinsen (1999)",
    A=(
        (),
        (0.8177227988124852,),
        (0.3199876375476427, 0.0659864263556022),
        (0.9214417194464946, 0.4997857776773573, -1.0969984448371582),
        (0.3552358559023322, 0.2390958372307326, 1.3918565724203246, -1.1092979392113465),
    ),
    b=(0.1370831520630755, -0.0183698531564020, 0.7397813985370780, -0.1907142565505889, 0.3322195591068374),
)  # fmt: skip

TRAPEZOIDAL = PredictorCorrector(
    "trapezoidal", "Euler predictor, trapezoidal corrector", 2, 2.0, "Sariyildiz & Temeltas, eqs 8-9, as PECE",
    predictors=((1.0,),), correctors=((1 / 2, 1 / 2),), startup_order=2,
)  # fmt: skip

ABM4 = PredictorCorrector(
    "abm4", "Adams-Bashforth-Moulton of order 4", 4, 1.284816263106356,
    "Bashforth & Adams (1883), Moulton (1926); start-up of Sariyildiz & Temeltas, eqs 10-17",
    predictors=((1.0,), (3 / 2, -1 / 2), (23 / 12, -16 / 12, 5 / 12), (55 / 24, -59 / 24, 37 / 24, -9 / 24)),
    correctors=((1 / 2, 1 / 2), (5 / 12, 8 / 12, -1 / 12), (9 / 24, 19 / 24, -5 / 24, 1 / 24)),
    startup_order=3,
)  # fmt: skip

SEMI_IMPLICIT = Mechanical("semi_implicit_euler", "semi-implicit Euler: v first, then q with the new v", 1, 2.0,
                           "Hairer, Lubich & Wanner (2006), I.1.2")  # fmt: skip

VARIATIONAL = Mechanical("variational", "variational midpoint, symplectic and implicit", 2, UNBOUNDED,
                         "Marsden & West (2001), 2.6.1")  # fmt: skip

SCIPY = tuple(
    Reference(name, f"{name} of scipy.integrate.solve_ivp", order, UNBOUNDED, source, scipy=name)
    for name, order, source in (
        ("DOP853", 8, "Hairer, Norsett & Wanner (1993)"),
        ("Radau", 5, "Hairer & Wanner (1996)"),
        ("LSODA", 12, "Petzold (1983)"),
    )
)

METHODS: dict[str, Method] = {
    m.name: m
    for m in (
        EULER, MIDPOINT, HEUN, TRAPEZOIDAL, ABM4, RK4, RK45, RKMK4, CG3, CG4, SEMI_IMPLICIT, VARIATIONAL, *SCIPY
    )
}  # fmt: skip
_ALIASES = {"trap": "trapezoidal", "dopri5": "rk45", "explicit_euler": "euler", "cg3": CG3.name, "cg4": CG4.name}


def method_named(name: str | Method) -> Method:
    """The method of that name, or an error that offers the nearest.

    Parameters
    ----------
    name : str or Method
        A name of `METHODS`, or a method, which comes back.

    Returns
    -------
    Method

    Raises
    ------
    ArgumentError
        For a name that is not known.

    Examples
    --------
    >>> import dualpin as dp
    >>> dp.integrators.method_named("rk4").order
    4
    """
    if isinstance(name, Method):
        return name
    found = METHODS.get(_ALIASES.get(name, name)) if isinstance(name, str) else None
    if found is None:
        raise ArgumentError(f"method {name!r} is not known; {nearest(str(name), METHODS, 'methods', most=20)}")
    return found
