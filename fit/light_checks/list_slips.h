// list_slips.h: the orders that a list of lights comes in by mistake, and which of them shading allows.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "capture/stack/survey.h"
#include "surface/image/colour.h"
#include "surface/maps/light.h"

namespace tangi {

// Photograph i has the light that is listed for order[i].
using ListOrdering = std::vector<std::size_t>;

// What happened to a list of n lights: positions in it, to those whose light they should have.
struct ListSlip {
    enum class Kind {
        shifted,  // by `shift`, from position `from` on; it runs the other way where `reversed`
        snaked,   // of rows of `row` lights, every second one runs the other way
        columns,  // `row` lights a row, taken column by column
        rows,     // the other way round: columns of `row` lights, taken row by row
        letters,  // 10 before 2: names were sorted by letters when the lights were put beside them
        counted,  // they were sorted as people count, and the lights were listed by letters
    };
    Kind kind = Kind::shifted;
    int shift = 0;
    std::size_t from = 0;
    bool reversed = false;
    std::size_t row = 0;

    std::size_t of(std::size_t i, std::size_t n) const;
};

std::string_view name_of(ListSlip::Kind kind);

// `sequence`: the photographs in the order that counts.
ListOrdering ordering_of(const ListSlip& slip, const ListOrdering& sequence,
                         const std::vector<Light>& lights);

// All that are tried of so many photographs: every shift of the list and of the reversed list, shifts by one
// from photographs inside of it, lights that stand in rows, and names that are sorted otherwise.
std::vector<ListSlip> list_slips(std::size_t photos);

// How much of what changes from photograph to photograph a list explains, by its order alone. A pixel of a
// matt relief is, relative to its mean, linear in the light's direction (Horn 1977, linearised), whatever its
// slope: so the changes of all pixels lie in the space that the three components of the lights span over the
// photographs. One matrix of the size of the list tells that of any order.
class ShadingChanges {
public:
    ShadingChanges(const Survey& survey, const Transfer& transfer);

    // [0..1] Of the changes' squares; 0 where nothing changes.
    double explained(const std::vector<Light>& lights, const ListOrdering& order) const;
    // [0..1] What three lights could explain at most.
    double by_any_three() const;

private:
    std::size_t photos_;
    std::vector<double> covariance_;  // [photo][photo]
    double all_ = 0;                  // its trace
};

}  // namespace tangi
