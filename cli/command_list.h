// command_list.h: the commands, one function and one source file each.
#pragma once

#include <memory>

#include "cli/command.h"

namespace tangi {

Command calibrate_command();
Command fit_command();
Command mosaic_command();
Command relight_command();
Command compare_command();
Command import_command();
Command export_command();
Command paint_command();
Command replay_command();
Command info_command();
Command generate_command();
Command palette_command();
Command match_command();
Command retouch_command();
Command quality_command();
Command demo_command();
Command damage_command();
Command fill_command();
Command varnish_command();
Command treatment_command();
Command archive_command();

}  // namespace tangi
