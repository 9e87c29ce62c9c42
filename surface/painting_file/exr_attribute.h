// exr_attribute.h: attributes of an EXR header (Imf::Header); for sources of this module only.
#pragma once

namespace tangi {

// `otherwise` where the header has no attribute of that name and type.
template <class Attribute, class Header, class Value>
Value attribute(const Header& header, const char* name, const Value& otherwise) {
    const auto* found = header.template findTypedAttribute<Attribute>(name);
    return found ? found->value() : otherwise;
}

}  // namespace tangi
