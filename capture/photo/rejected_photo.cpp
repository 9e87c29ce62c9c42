#include "capture/photo/rejected_photo.h"

namespace tangi {

void require_few(const std::vector<RejectedPhoto>& lost, std::size_t all, std::size_t least,
                 const std::string& what) {
    if (lost.empty() || (3 * lost.size() < all && all - lost.size() >= least)) return;
    const std::string& reason = lost.front().reason;
    if (lost.size() == 1) throw Error(reason);
    fail("{} ({} of {} photographs of {} cannot be used, which is too many to go on without)", reason,
         lost.size(), all, what);
}

nlohmann::json to_json(const std::vector<RejectedPhoto>& rejected) {
    nlohmann::json list = nlohmann::json::array();
    for (const RejectedPhoto& photo : rejected)
        list.push_back({{"name", photo.name}, {"reason", photo.reason}});
    return list;
}

}  // namespace tangi
