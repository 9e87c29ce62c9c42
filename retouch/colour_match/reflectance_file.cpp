#include "retouch/colour_match/reflectance_file.h"

#include <sstream>
#include <vector>

#include "surface/base/error.h"
#include "surface/file/atomic_file.h"

namespace tangi {

Spectrum parse_reflectance(std::string_view text, const std::string& where) {
    std::vector<std::pair<double, double>> samples;
    std::istringstream lines{std::string(text)};
    std::string line;
    for (int number = 1; std::getline(lines, line); ++number) {
        if (number == 1 && line.starts_with("\xef\xbb\xbf")) line.erase(0, 3);
        for (char& c : line)
            if (c == ',' || c == ';' || c == '\t' || c == '\r') c = ' ';
        const auto first = line.find_first_not_of(' ');
        if (first == std::string::npos || line[first] == '#') continue;
        std::istringstream cells(line);
        double nm = 0, reflectance = 0;
        std::string rest;
        if (!(cells >> nm >> reflectance) || cells >> rest) {
            if (number == 1) continue;  // names of the columns
            fail("{}: line {}: is not a wavelength in nm and a reflectance", where, number);
        }
        if (!(reflectance >= 0 && reflectance <= 1))
            fail("{}: line {}: reflects {} at {} nm; reflectances are 0 to 1 (per cent: divide by 100)",
                 where, number, reflectance, nm);
        if (!samples.empty() && !(nm > samples.back().first && nm <= samples.back().first + 50))
            fail("{}: line {}: {} nm follows {} nm; wavelengths increase, by 50 nm at most", where, number,
                 nm, samples.back().first);
        samples.emplace_back(nm, reflectance);
    }
    if (samples.size() < 2) fail("{}: holds no wavelengths in nm with reflectances, one pair a line", where);
    if (samples.front().first > kBand_nm.front() || samples.back().first < kBand_nm.back())
        fail("{}: goes from {} to {} nm; 410 to 680 nm are needed", where, samples.front().first,
             samples.back().first);
    Spectrum result;
    std::size_t above = 1;
    for (std::size_t band = 0; band < kBands; ++band) {
        const double nm = static_cast<double>(kBand_nm[band]);
        while (samples[above].first < nm) ++above;
        const auto& [nm0, r0] = samples[above - 1];
        const auto& [nm1, r1] = samples[above];
        result[band] = static_cast<float>(r0 + (r1 - r0) * (nm - nm0) / (nm1 - nm0));
    }
    return result;
}

Spectrum read_reflectance(const std::filesystem::path& path) {
    return parse_reflectance(read_text_file(path), path.string());
}

}  // namespace tangi
