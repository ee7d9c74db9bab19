"""Places in what the outer loops carry on, each in SI.

Eq. 22's states, lagged references and F_ref come first, then what the state estimator knows, then
the mass that is learnt on line with its regression.
"""

from __future__ import annotations

# What Eq. 22 carries on, lagged references, and F_ref.
LAG_1, LAG_2, INTEGRAL, LAST_ERROR, REFERENCE, VELOCITY_REFERENCE, FORCE = range(7)
# The state estimator's position [m], velocity [m/s] and load force [N], and v_ref a tick ago.
POSITION_HEARD, VELOCITY_HEARD, LOAD_HEARD, LAST_VELOCITY_REFERENCE = range(7, 11)
# The mass that is fed forward [kg], v_ref and its slope behind the regression's lag.
MASS, LAGGED_VELOCITY, LAGGED_ACCELERATION = range(11, 14)
REGRESSORS = 4
FACTORS = 14  # of the regressors, (4,)
COVARIANCE = FACTORS + REGRESSORS  # (4, 4) by rows
OUTER_STATES = COVARIANCE + REGRESSORS * REGRESSORS
