"""Guaranteed worst cases over a continuous box of plants, with exact dead time, and as sampled.

A grid of plants and frequencies can only miss. Here every figure of the linear loops gets an
*attained* value, with the plant and the frequency that have it, and a *bound* that no plant of the
box exceeds at any frequency, both as near to one another as was asked for, or marked as open.

What is guaranteed
    The bound holds for every mass, delay, τ_A and τ_B of the box, all real values between the ends,
    and for every frequency from 0 to infinity, of exactly the loops that ``mptune.loops`` states:
    Eq. 11 to Eq. 22, dead time as e^{−jωd}, the measurement path as it runs at T_S,fast, and the
    sampled loop with all of its aliases. A proof that a figure is below its bound implies that the
    denominator does not vanish, so that no plant of the box lies on the boundary of stability: if
    one is stable, all are. Of a bracket the lower end is guaranteed in the same sense.

What it rests on
    * On floating point: every ball operation adds 1e-15 of its result's size to its radius, more
      than its rounding, without fast-math; sin, cos, log and sqrt of the C library are right within
      4 units in the last place. Nothing rests on a number of points.
    * On the tails' formulas beyond the last frequency (``tails``), and on the formula for what the
      finite sum of a sampled loop leaves out (``sampled``); both are counted in full.
    * For stability, on one plant's count of encirclements (``mptune.loops.stability``), or on its
      multipliers as computed in floating point (``mptune.loops.sampled``).
    * The median is one sample, as everywhere in the linear loops; measured members and lines of
      hoses are none of the box: the linear family knows no dynamics of hoses.

What is not claimed
    Attained values are the best of some local ascents; they err on the optimistic side, by no more
    than the gap. Figures below 1e-3 are not told apart from 1e-3.

=============  =====================================================================================
File           Holds
=============  =====================================================================================
``problem``    ``BoxedLoop``, ``PlantBox``, ``Point``: what is asked about
``bounds``     ``bound``: one figure, attained and guaranteed
``stability``  ``box_stability``: all plants stable, or a witness
``radius``     ``radius``: by what factor the box may grow
``margins``    ``margin``: gain, phase and delay margin at F_ref
``envelope``   ``envelope``: a figure's bound over frequency
``result``     ``Bound``, ``BoxStability``, ``Bracket``: what comes out
``balls``      complex balls with a derivative; ``discs``, ``figures``, ``aliases``, ``enclosure``,
               ``search``, ``proof``: the certificate, from the inside out
``climb``      attained values; ``ascent``: from one to a proved bound
=============  =====================================================================================
"""
