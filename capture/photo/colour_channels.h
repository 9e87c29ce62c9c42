// colour_channels.h: which of a file's channels are the picture: grey, or red, green and blue.
#pragma once

#include <string>
#include <vector>

namespace tangi {

struct ColourChannels {
    int first = 0;
    int count = 0;           // 1 or 3, one behind the other; 0 where nothing says which they are
    std::string doubt = {};  // what is to be told of them, without the file's name; empty: nothing
};

// By the channels' names ("R", "diffuse.R", "450nm", ""), in the file's order, and which of them is alpha
// (-1: none). `names_tell`: the format names channels (OpenEXR); else names but for the first three are made
// up, and the first are the picture, if no more than one other, which may be an alpha that is not called so,
// comes behind: files of more have bands of a spectrum, and red, green and blue need not be among them.
// `doubt` says then what there is and what to do.
ColourChannels colour_channels(const std::vector<std::string>& names, int alpha, bool names_tell);

}  // namespace tangi
