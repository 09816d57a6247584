// SPDX-License-Identifier: GPL-3.0-or-later
#include "draping/joined.h"

namespace toile {

DrapeResult joined(DrapeResult before, DrapeResult now) {
    now.levels.insert(now.levels.begin(), before.levels.begin(), before.levels.end());
    now.seconds.insert(now.seconds.begin(), before.seconds.begin(), before.seconds.end());
    now.contact.seconds += before.contact.seconds;
    return now;
}

} // namespace toile
