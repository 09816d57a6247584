// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "draping/solve/settle.h"

namespace toile {

struct TakeUpOptions {
    double first = 0;       ///< residual at which forces are first taken up; at most that of the settling: at rest alone
    double nearer = 0.3;    ///< each time this much nearer to rest
    double time_step = 1;   ///< s, of the first step after, while farther from rest
    int most_rounds = 30;
};

/// Brings cloth with constraints to rest (the method of multipliers): settles by `settle`, has `take_up` take up as forces what the
/// constraints' stiffness held by being violated (see Energy::take_up), and so on until they are kept and all is at rest. While
/// they are far from kept, rest need not be near either (inexact: Bertsekas, Constrained Optimization and Lagrange Multiplier
/// Methods, 1982, 2.5). The end is `iterations` when rounds are over before.
SettleResult settle_and_take_up(const std::function<SettleResult(const SettleOptions&)>& settle,
                                const std::function<bool()>& take_up, const SettleOptions& options, const TakeUpOptions& how = {});

} // namespace toile
