// preprocess.h: the first look at all photographs of a stack: which are usable, how they are encoded, how the
// camera moved.
#pragma once

#include "capture/photo/rejected_photo.h"
#include "capture/radiometry/transfer_estimate.h"
#include "capture/registration/registration.h"
#include "capture/registration/sharpening.h"
#include "capture/stack/reduced_photos.h"
#include "capture/stack/survey.h"
#include "fit/light_checks/list_order.h"

namespace tangi {

struct Preprocessed {
    Survey survey;
    TransferEstimate transfer;
    Registration registration;            // empty where not asked for
    std::vector<RejectedPhoto> rejected;  // damaged, black, copies of others, turned, not to be registered
    // Of the photographs before registration, where that left some out: under a light that is not its own a
    // photograph is not found again, and what is left of a list has no order to tell.
    struct OrderBefore {
        ListOrder order;
        std::vector<std::string> names;
    };
    std::optional<OrderBefore> order_before{};
    std::string turned_doubt{};  // turned_photos.h; empty where there is none
    Sharpening sharpening;
    ReducedPhotos reduced{};  // of the stack's photographs, where the picture is large; else empty
};

// Surveys the stack and takes photographs out of it that cannot be used, each with a warning that names it;
// where asked for, also registers it, and where that moved something, surveys it once more as registered.
// Photographs that turn out to be damaged when they are decoded are left out, and the others looked at anew.
// `least_reduction`: of Preprocessed::reduced, 1 of pictures that need none. Throws Error where too few
// remain, as require_few().
Preprocessed preprocess(Stack& stack, bool register_photos, const Progress& progress,
                        int least_reduction = 1);

// The part of it that knows nothing of lights: takes photographs that are damaged, or the same picture as
// another (duplicate_photos.h), out of stack.photos, with a warning for each, and returns them. Throws Error
// as require_few(), at least one being left. `kept`: where to put the survey of those that stay; null where
// nobody asks.
std::vector<RejectedPhoto> leave_out_damaged_and_copies(Stack& stack, const Progress& progress,
                                                        Survey* kept = nullptr);

}  // namespace tangi
