#include "capture/photo/rejected_photo.h"

namespace tangi {

void require_few(const std::vector<LeftOut>& lost, std::size_t all, std::size_t least,
                 const std::string& what) {
    if (lost.empty() || (3 * lost.size() < all && all - lost.size() >= least)) return;
    const std::string& reason = lost.front().reason;
    if (lost.size() == 1) throw Error(reason);
    fail("{} ({} of {} photographs of {} cannot be used, which is too many to go on without)", reason,
         lost.size(), all, what);
}

nlohmann::json to_json(const std::vector<LeftOut>& left_out) {
    nlohmann::json list = nlohmann::json::array();
    for (const LeftOut& photo : left_out) list.push_back({{"name", photo.name}, {"reason", photo.reason}});
    return list;
}

}  // namespace tangi
