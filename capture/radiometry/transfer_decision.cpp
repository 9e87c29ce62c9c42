#include "capture/radiometry/transfer_decision.h"

#include <fmt/format.h>

#include <optional>
#include <string>

#include "capture/photo/stated_transfer.h"
#include "capture/stack/photo_profiles.h"
#include "surface/base/error.h"

namespace tangi {

namespace {

constexpr double kContrary = 0.08;   // [1] from which on two curves contradict each other; sRGB and 2.2: 0.01
constexpr std::size_t kTelling = 7;  // photographs: of fewer, three numbers a pixel explain nearly all

// What all photographs state; empty where they do not agree.
struct Statement {
    std::optional<StatedTransfer> stated;
    std::string contradiction;
};

std::string in_words(const std::optional<StatedTransfer>& stated) {
    if (!stated) return "nothing";
    return fmt::format("{} ({})", stated->transfer ? stated->transfer->name() : "a curve of its own",
                       stated->source);
}

Statement statement_of(const Stack& stack) {
    Statement result;
    const StackPhoto* first = nullptr;
    for (const StackPhoto& photo : stack.photos) {
        const auto stated = transfer_of_metadata(metadata_in(stack, photo.path));
        if (!first) {
            first = &photo;
            result.stated = stated;
        } else if (in_words(stated) != in_words(result.stated)) {
            result.contradiction = fmt::format(
                "{}: {} says that it is stored as {}, {} says {}; metadata are not used, and the photographs "
                "should be "
                "stored alike",
                stack.folder.string(), first->path.filename().string(), in_words(result.stated),
                photo.path.filename().string(), in_words(stated));
            result.stated.reset();
            return result;
        }
    }
    return result;
}

void append(std::string& text, const std::string& more) { text += (text.empty() ? "" : "\n") + more; }

}  // namespace

TransferEstimate decide_transfer(const Stack& stack, const Survey& survey) {
    TransferEstimate result = estimate_transfer(stack, survey);
    const bool given = result.source == "given" && !stack.transfer_of_chart && !stack.development;
    if (result.source != "estimated" && !given) return result;
    const Statement said = statement_of(stack);
    if (given) {
        const StatedTransfer* stated = said.stated && said.stated->binding ? &*said.stated : nullptr;
        if (stated && stated->transfer && difference(*stated->transfer, result.transfer) > kContrary)
            append(result.warning,
                   fmt::format("{}: stored as {} by the photographs' {}, but {} is given, which is used",
                               stack.folder.string(), stated->transfer->name(), stated->source,
                               result.transfer.name()));
        return result;
    }
    if (!said.contradiction.empty()) append(result.warning, said.contradiction);
    if (!said.stated) return result;
    const std::string& source = said.stated->source;
    if (!said.stated->transfer) {
        append(result.warning,
               fmt::format(
                   "{}: the tone curve of the photographs' {} is neither linear, nor sRGB, nor a gamma, nor "
                   "smooth, and is "
                   "not used; {} was estimated from the photographs; convert them to linear light or sRGB",
                   stack.folder.string(), source, result.transfer.name()));
        return result;
    }
    const Transfer stated = *said.stated->transfer;
    const bool contrary =
        difference(stated, result.transfer) > kContrary && speaks_against(stated, result, stack, survey);
    if (!said.stated->binding && contrary) {
        append(
            result.warning,
            fmt::format("{}: the photographs' {} says {}, but they look like {}, which is used; cameras and "
                        "programs write the former blindly; if it is right, say so with --transfer {}",
                        stack.folder.string(), source, stated.name(), result.transfer.name(), stated.name()));
        return result;
    }
    if (contrary && stack.photos.size() >= kTelling)
        result.warning = fmt::format(
            "{}: stored as {} by the photographs' {}, which is used, but they look like {}, as photographs "
            "under near or unequal lights can; only where the profile is known to be wrong, say so with "
            "--transfer {}",
            stack.folder.string(), stated.name(), source, result.transfer.name(), result.transfer.name());
    else
        result.warning.clear();
    result.doubt.clear();  // what was doubtful is settled
    result.transfer = stated;
    result.source = source;
    return result;
}

}  // namespace tangi
