// exr_attribute.h: attributes of an EXR header (Imf::Header); for sources of this module only.
#pragma once

namespace tangi {

// `otherwise` where the header has no attribute of that name and type.
template <class Attribute, class Header, class Value>
Value attribute(const Header& header, const char* name, const Value& otherwise) {
    const auto* found = header.template findTypedAttribute<Attribute>(name);
    return found ? found->value() : otherwise;
}

// [1] 0..1 as ReflectanceModel has it; files of version 0.1 call it haze.
template <class Attribute, class Header>
double second_lobe_weight_of(const Header& header) {
    return attribute<Attribute>(header, "second_lobe_weight", attribute<Attribute>(header, "haze", 0.0));
}

}  // namespace tangi
