#include "surface/reflectance/ward.h"

namespace tangi {

std::string_view name_of(WardModel model) { return kWardModels[static_cast<std::size_t>(model)].name; }

std::optional<WardModel> ward_model_named(std::string_view name) {
    for (const WardModelTraits& traits : kWardModels)
        if (name == traits.name) return traits.model;
    return std::nullopt;
}

std::string ward_model_names() {
    std::string names;
    for (const WardModelTraits& traits : kWardModels) {
        if (!names.empty()) names += traits.model == kWardModels.back().model ? " or " : ", ";
        names += traits.name;
    }
    return names;
}

}  // namespace tangi
