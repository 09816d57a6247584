// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/solve/take_up.h"

#include <algorithm>

namespace toile {

SettleResult settle_and_take_up(const std::function<SettleResult(const SettleOptions&)>& settle,
                                const std::function<bool()>& take_up, const SettleOptions& options, const TakeUpOptions& how) {
    SettleOptions some = options;
    some.tolerance = std::max(options.tolerance, how.first);
    for (int round = 0;; ++round) {
        SettleResult r = settle(some);
        if (r.end != SettleEnd::settled) return r;
        const bool violated = take_up();
        if (!violated && some.tolerance == options.tolerance) return r;
        if (round == how.most_rounds) {
            r.end = SettleEnd::iterations;
            return r;
        }
        some.tolerance = std::max(options.tolerance, how.nearer * some.tolerance);
        if (how.first > options.tolerance) some.time_step = how.time_step;
    }
}

} // namespace toile
