// SPDX-License-Identifier: GPL-3.0-or-later
#include "io/start_from.h"

#include "draping/carry_drape.h"
#include "io/garment_obj.h"

#include <algorithm>

namespace toile {

Points start_from(const ReadGarment& earlier, const Garment& garment, const std::string& name) {
    if (!earlier.flat)
        throw InputError(name + " has no texture coordinates, by which its cloth could be recognised");
    std::vector<int> panel_of;
    const std::vector<std::string> names = group_names(garment);
    for (std::size_t p = 0; p < names.size(); ++p) {
        const auto& known = earlier.garment.panel_names; // GLB keeps the name, OBJ what fits
        const auto it = std::find_if(known.begin(), known.end(), [&](const std::string& k) {
            return k == names[p] || k == garment.panel_names[p];
        });
        panel_of.push_back(int(it - known.begin()));
        if (it == known.end() || !can_carry(earlier.garment, panel_of.back()))
            throw InputError(name + " has no panel '" + garment.panel_names[p] + "' to start from");
    }
    return carry_drape(earlier.garment, earlier.x, garment, panel_of);
}

} // namespace toile
