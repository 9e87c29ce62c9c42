#include "fit/pipeline/preprocess.h"

#include <algorithm>

#include "capture/radiometry/full_scale.h"
#include "capture/radiometry/transfer_decision.h"
#include "capture/stack/compression.h"
#include "capture/stack/duplicate_photos.h"
#include "fit/light_checks/turned_photos.h"

namespace tangi {

namespace {

constexpr std::size_t kFewestUsable = 4;

std::vector<std::string> names_of(const Stack& stack) {
    std::vector<std::string> names;
    for (const auto* photos : {&stack.photos, &stack.held_out})
        for (const StackPhoto& photo : *photos) names.push_back(photo.light.name);
    return names;
}

// Adds what was taken out of a stack of these names and is not told yet.
void note_missing(const std::vector<std::string>& before, const Stack& stack, const std::string& reason,
                  std::vector<RejectedPhoto>& rejected) {
    const std::vector<std::string> now = names_of(stack);
    for (const std::string& name : before)
        if (std::find(now.begin(), now.end(), name) == now.end() &&
            std::none_of(rejected.begin(), rejected.end(),
                         [&](const RejectedPhoto& photo) { return photo.name == name; }))
            rejected.push_back({name, reason});
}

// Which of the photographs are still in the stack.
std::vector<bool> still_in(const Stack& stack, const std::vector<StackPhoto>& all) {
    std::vector<bool> kept;
    for (const StackPhoto& photo : all)
        kept.push_back(std::any_of(stack.photos.begin(), stack.photos.end(),
                                   [&](const StackPhoto& k) { return k.path == photo.path; }));
    return kept;
}

void reject_duplicates(Stack& stack, Survey& surveyed, std::vector<RejectedPhoto>& rejected) {
    const std::vector<std::string> before = names_of(stack);
    leave_out_black_photos(stack, surveyed);
    note_missing(before, stack, "it is black", rejected);
    leave_out_copies(stack, surveyed, rejected);
}

// To be filled in; of no stack where the picture is small.
ReducedPhotos reduced_photos_of(const Stack& stack, int least) {
    const int reduction = std::max(ReducedPhotos::reduction_for(stack.width(), stack.height()), least);
    return reduction > 1 ? ReducedPhotos(stack, reduction) : ReducedPhotos();
}

Preprocessed look_once(Stack& stack, bool register_photos, int least_reduction, const Progress& progress) {
    Preprocessed result;
    warn_of_compression(stack);
    const std::vector<StackPhoto> all = stack.photos;
    PictureCollector collected(stack);
    result.reduced = reduced_photos_of(stack, least_reduction);
    const auto reduce = [&result](const Band& band) {
        if (!result.reduced.empty()) result.reduced.add(band);
    };
    result.survey = survey(stack, {}, progress, [&](const Band& band) {
        collected.add(band);
        reduce(band);
    });
    if (take_full_scale(stack, result.survey))
        return look_once(stack, register_photos, least_reduction, progress);
    tell_pixels_without_number(stack, result.survey);
    reject_duplicates(stack, result.survey, result.rejected);
    result.turned_doubt = leave_out_turned(stack, result.survey, result.rejected);
    const std::vector<bool> kept = still_in(stack, all);
    collected.keep(kept);
    if (!result.reduced.empty()) result.reduced.keep(kept);
    result.sharpening = find_sharpening(collected, rounding_of_jpeg(stack));
    result.transfer = decide_transfer(stack, result.survey);
    if (!register_photos) return result;
    const std::vector<std::string> before = names_of(stack);
    const Stack unregistered = stack;
    const std::size_t photos = stack.photos.size();
    result.registration = register_stack(stack, collected, result.transfer.transfer, progress);
    note_missing(before, stack, "it cannot be registered to " + result.registration.reference,
                 result.rejected);
    if (!result.registration.moved && stack.photos.size() == photos) return result;
    if (stack.photos.size() < photos)
        result.order_before = {check_list_order(result.survey, result.transfer.transfer, unregistered),
                               {before.begin(), before.begin() + static_cast<std::ptrdiff_t>(photos)}};
    require_enough_lights(stack.lights(), stack.folder.string());
    result.reduced = reduced_photos_of(stack, least_reduction);
    result.survey = survey(stack, {}, Progress([&](std::string_view, double done) {
                               return !progress || progress("survey as registered", done);
                           }),
                           reduce);
    result.transfer = decide_transfer(stack, result.survey);
    return result;
}

// Takes the photograph that an error is about out of the stack; throws it again where it is about none.
void leave_out_damaged(Stack& stack, const PhotoError& error, std::vector<RejectedPhoto>& rejected) {
    bool found = false;
    for (auto* photos : {&stack.photos, &stack.held_out})
        std::erase_if(*photos, [&](const StackPhoto& photo) {
            const bool is_it = photo.path == error.path() ||
                               std::any_of(photo.exposures.begin(), photo.exposures.end(),
                                           [&](const Exposure& e) { return e.path == error.path(); });
            if (is_it) rejected.push_back({photo.light.name, error.what()});
            found = found || is_it;
            return is_it;
        });
    if (!found) throw error;
    stack.warnings.push_back(fmt::format("{}; rejected", error.what()));
}

}  // namespace

std::vector<RejectedPhoto> leave_out_damaged_and_copies(Stack& stack, const Progress& progress,
                                                        Survey* kept) {
    constexpr std::size_t kFewest = 1;
    const std::size_t all = stack.photos.size() + stack.held_out.size();
    std::vector<RejectedPhoto> rejected;
    while (true) try {
            Survey surveyed = survey(stack, {}, progress);
            if (take_full_scale(stack, surveyed)) continue;
            tell_pixels_without_number(stack, surveyed);
            const std::vector<std::string> before = names_of(stack);
            leave_out_black_photos(stack, surveyed, kFewest);
            note_missing(before, stack, "it is black", rejected);
            leave_out_copies(stack, surveyed, rejected, kFewest);
            if (kept) *kept = std::move(surveyed);
            return rejected;
        } catch (const PhotoError& error) {
            leave_out_damaged(stack, error, rejected);
            require_few(rejected, all, kFewest, stack.folder.string());
        }
}

Preprocessed preprocess(Stack& stack, bool register_photos, const Progress& progress, int least_reduction) {
    const std::size_t all = stack.photos.size() + stack.held_out.size();
    std::vector<RejectedPhoto> damaged;
    while (true) {
        Stack looked_at = stack;
        try {
            const std::string again = fmt::format("survey without {} damaged", damaged.size());
            Preprocessed result =
                look_once(looked_at, register_photos, least_reduction,
                          damaged.empty() ? progress : Progress([&](std::string_view stage, double done) {
                              return !progress || progress(stage == "survey" ? again : stage, done);
                          }));
            result.rejected.insert(result.rejected.begin(), damaged.begin(), damaged.end());
            stack = std::move(looked_at);
            return result;
        } catch (const PhotoError& error) {
            leave_out_damaged(stack, error, damaged);
            require_few(damaged, all, kFewestUsable, stack.folder.string());
            require_enough_lights(stack.lights(), stack.folder.string());
        }
    }
}

}  // namespace tangi
