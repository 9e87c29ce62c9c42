// treatment_names.cpp: the words of treatment.h, as files and flags have them.
#include <span>

#include "retouch/treatment/treatment.h"

namespace tangi {

namespace {

constexpr std::array<std::string_view, 4> kRoleNames = {"fill", "isolating_varnish", "retouch", "varnish"};
constexpr std::array<std::string_view, 5> kStateNames = {"before", "cleaned", "filled", "retouched",
                                                         "varnished"};

template <class Value>
std::optional<Value> named(std::span<const std::string_view> names, std::string_view name) {
    for (std::size_t i = 0; i < names.size(); ++i)
        if (names[i] == name) return static_cast<Value>(i);
    return {};
}

}  // namespace

std::string_view name_of(LayerRole role) { return kRoleNames[static_cast<std::size_t>(role)]; }
std::string_view name_of(TreatmentStage state) { return kStateNames[static_cast<std::size_t>(state)]; }

std::optional<LayerRole> layer_role_named(std::string_view name) {
    return named<LayerRole>(kRoleNames, name);
}
std::optional<TreatmentStage> treatment_stage_named(std::string_view name) {
    return named<TreatmentStage>(kStateNames, name);
}

TreatmentStage shown_from(LayerRole role) {
    switch (role) {
        case LayerRole::fill:
            return TreatmentStage::filled;
        case LayerRole::isolating_varnish:
        case LayerRole::retouch:
            return TreatmentStage::retouched;
        case LayerRole::varnish:
            break;
    }
    return TreatmentStage::varnished;
}

}  // namespace tangi
