#include "surface/reflectance/ward.h"

namespace tangi {

std::string_view name_of(WardModel model) {
    switch (model) {
        case WardModel::ward1992:
            return "ward1992";
        case WardModel::duer:
            return "duer";
        case WardModel::bounded:
            break;
    }
    return "bounded";
}

std::optional<WardModel> ward_model_named(std::string_view name) {
    for (const WardModel model : {WardModel::ward1992, WardModel::duer, WardModel::bounded})
        if (name == name_of(model)) return model;
    return std::nullopt;
}

}  // namespace tangi
