#include "cli/command_list.h"

namespace tangi {

const std::vector<Command>& commands() {
    static const std::vector<Command> table = {
        calibrate_command(), fit_command(),     mosaic_command(),  relight_command(),   compare_command(),
        paint_command(),     replay_command(),  import_command(),  export_command(),    info_command(),
        generate_command(),  palette_command(), match_command(),   damage_command(),    fill_command(),
        retouch_command(),   quality_command(), varnish_command(), treatment_command(), archive_command(),
        demo_command()};
    return table;
}

}  // namespace tangi
