#include "cli/help_pages.h"

#include <fmt/format.h>

#include <CLI/App.hpp>
#include <CLI/Config.hpp>
#include <CLI/Formatter.hpp>

#include "surface/base/error.h"
#include "surface/file/atomic_file.h"
#include "surface/file/version.h"

namespace tangi {

namespace {

std::string replaced(std::string text, std::string_view what, std::string_view by) {
    for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += by.size())
        text.replace(at, what.size(), by);
    return text;
}

// Text in a man page: groff's own characters, and lines that would be requests.
std::string in_roff(std::string text) {
    text = replaced(replaced(std::move(text), "\\", "\\e"), "-", "\\-");
    return text.starts_with('.') || text.starts_with('\'') ? "\\&" + text : text;
}

std::vector<std::string> names_of(const CLI::Option& option) {
    std::vector<std::string> names;
    for (const std::string& name : option.get_snames()) names.push_back("-" + name);
    for (const std::string& name : option.get_lnames()) names.push_back("--" + name);
    return names;
}

bool takes_value(const CLI::Option& option) { return option.get_items_expected_max() > 0; }

// The words that a flag may have, where it may only have these: the name of its check holds them (flags.cpp).
std::vector<std::string> words_of(const CLI::Option& option) {
    try {
        const std::string name = const_cast<CLI::Option&>(option).get_validator(0)->get_name();
        return name.empty() ? std::vector<std::string>() : CLI::detail::split(name, ' ');
    } catch (const CLI::OptionNotFound&) {
        return {};
    }
}

std::vector<const CLI::Option*> flags_of(const CLI::App& command) {
    std::vector<const CLI::Option*> flags;
    for (const CLI::Option* option : command.get_options())
        if (!names_of(*option).empty()) flags.push_back(option);
    return flags;
}

std::vector<const CLI::App*> commands_of(const CLI::App& program) {
    return program.get_subcommands([](const CLI::App*) { return true; });
}

std::string value_of(const CLI::Option& option) {
    if (!takes_value(option)) return "";
    const std::vector<std::string> words = words_of(option);
    if (!words.empty()) return fmt::format("{}", fmt::join(words, "|"));
    return option.get_option_text().empty() ? option.get_type_name() : option.get_option_text();
}

std::string options_in_roff(const CLI::App& command) {
    std::string text;
    for (const CLI::Option* option : flags_of(command)) {
        std::vector<std::string> names;
        for (const std::string& name : names_of(*option)) names.push_back("\\fB" + in_roff(name) + "\\fR");
        const std::string value = value_of(*option);
        text += fmt::format(
            ".TP\n{}{}\n{}\n", fmt::join(names, ", "), value.empty() ? "" : " \\fI" + in_roff(value) + "\\fR",
            in_roff((option->get_required() ? "Required: " : "") + option->get_description()));
        if (!option->get_default_str().empty())
            text += fmt::format("Default: {}.\n", in_roff(option->get_default_str()));
    }
    return text;
}

std::string page_head(const std::string& name, const std::string& summary) {
    return fmt::format(
        ".TH {} 1 \"\" \"TangiPaint {}\" \"User Commands\"\n.SH NAME\n{} \\- {}\n.SH SYNOPSIS\n",
        replaced(name, " ", "\\-"), version(), replaced(name, " ", "\\-"), in_roff(summary));
}

constexpr const char* kExitStatus =
    ".SH EXIT STATUS\n.TP\n0\nDone.\n.TP\n1\nSomething is wrong with a file or the data.\n.TP\n2\nThe "
    "command "
    "was mistyped.\n.TP\n3\nThe numbers are poor; files are written.\n.TP\n70\nA fault of the program.\n"
    ".TP\n130\nStopped by Ctrl\\-C.\n";

std::string man_page(const CLI::App& command) {
    std::string text = page_head("tangipaint " + command.get_name(), command.get_description());
    text += fmt::format("\\fBtangipaint {}\\fR", command.get_name());
    std::string arguments;
    for (const CLI::Option* option : command.get_options()) {
        if (!option->get_positional() || !names_of(*option).empty()) continue;
        const std::string name = in_roff(option->get_name(true));
        text += option->get_required() ? " \\fI" + name + "\\fR" : " [\\fI" + name + "\\fR]";
        arguments += fmt::format(".TP\n\\fI{}\\fR\n{}\n", name, in_roff(option->get_description()));
    }
    text += " [\\fIOPTIONS\\fR]\n";
    if (!arguments.empty()) text += ".SH ARGUMENTS\n" + arguments;
    return text + ".SH OPTIONS\n" + options_in_roff(command) + kExitStatus +
           ".SH SEE ALSO\n.BR tangipaint (1)\n";
}

std::string man_page_of_program(const CLI::App& program) {
    std::string text = page_head("tangipaint", "relightable digital twins of paintings from photographs");
    text +=
        "\\fBtangipaint\\fR \\fICOMMAND\\fR [\\fIARGUMENTS\\fR] [\\fIOPTIONS\\fR]\n.SH DESCRIPTION\n.nf\n";
    for (const std::string& line : CLI::detail::split(program.get_description(), '\n'))
        text += in_roff(line) + "\n";
    text +=
        ".fi\nProgress and warnings go to standard error, one JSON result to standard output.\n.SH "
        "COMMANDS\n";
    std::string others;
    for (const CLI::App* command : commands_of(program)) {
        text +=
            fmt::format(".TP\n\\fB{}\\fR\n{}\n", command->get_name(), in_roff(command->get_description()));
        others += fmt::format("{}.BR tangipaint\\-{} (1)", others.empty() ? "" : ",\n", command->get_name());
    }
    return text + ".SH OPTIONS\n" + options_in_roff(program) + kExitStatus + ".SH SEE ALSO\n" + others + "\n";
}

// Flags of a command, and in the inner case the words that those of a few words take.
std::string bash_completion(const CLI::App& program) {
    std::string cases, commands;
    for (const CLI::App* command : commands_of(program)) {
        std::string values;
        std::vector<std::string> names;
        for (const CLI::Option* option : flags_of(*command)) {
            const std::vector<std::string> own = names_of(*option), words = words_of(*option);
            names.insert(names.end(), own.begin(), own.end());
            if (!words.empty())
                values += fmt::format("            {}) words='{}' ;;\n", fmt::join(own, "|"),
                                      fmt::join(words, " "));
            else if (takes_value(*option))
                values += fmt::format("            {}) return ;;\n", fmt::join(own, "|"));
        }
        commands += (commands.empty() ? "" : " ") + command->get_name();
        cases += fmt::format(
            "        {}) case $previous in\n{}            *) [[ $current != -* ]] || words='{}' ;;\n"
            "            esac ;;\n",
            command->get_name(), values, fmt::join(names, " "));
    }
    return "# bash completion for tangipaint\n_tangipaint() {\n"
           "    local current=${COMP_WORDS[COMP_CWORD]} previous=${COMP_WORDS[COMP_CWORD-1]} words=\n"
           "    if [ \"$COMP_CWORD\" -eq 1 ] || [ \"$previous\" = help ]; then\n        words='" +
           commands + "'\n    else\n        case ${COMP_WORDS[1]} in\n" + cases +
           "        esac\n    fi\n    COMPREPLY=($(compgen -W \"$words\" -- \"$current\"))\n}\n"
           "complete -o default -F _tangipaint tangipaint\n";
}

std::string in_quotes(const std::string& text) { return "'" + replaced(text, "'", "'\\''") + "'"; }

std::string zsh_completion(const CLI::App& program) {
    std::string commands, cases;
    for (const CLI::App* command : commands_of(program)) {
        commands += "        " +
                    in_quotes(command->get_name() + ":" + replaced(command->get_description(), ":", "\\:")) +
                    "\n";
        cases += fmt::format("    {}) _arguments \\\n", command->get_name());
        for (const CLI::Option* option : flags_of(*command))
            for (const std::string& name : names_of(*option)) {
                std::string text = replaced(option->get_description(), "[", "\\[");
                text = replaced(replaced(std::move(text), "]", "\\]"), ":", "\\:");
                text = fmt::format("{}[{}]", name, text);
                const std::vector<std::string> words = words_of(*option);
                if (!words.empty())
                    text += fmt::format(":value:({})", fmt::join(words, " "));
                else if (takes_value(*option))
                    text += ":value:_files";
                cases += "        " + in_quotes(text) + " \\\n";
            }
        cases += "        '*:file:_files' ;;\n";
    }
    return "#compdef tangipaint\n# zsh completion for tangipaint\nif (( CURRENT == 2 )); then\n    local -a "
           "commands=(\n" +
           commands +
           "    )\n    _describe command commands\nelse\n    local command=$words[2]\n    shift words\n    "
           "(( CURRENT-- ))\n"
           "    case $command in\n" +
           cases + "    esac\nfi\n";
}

std::string fish_completion(const CLI::App& program) {
    std::string text = "# fish completion for tangipaint\n";
    for (const CLI::App* command : commands_of(program)) {
        text += fmt::format("complete -c tangipaint -n __fish_use_subcommand -f -a {} -d {}\n",
                            command->get_name(), in_quotes(command->get_description()));
        for (const CLI::Option* option : flags_of(*command)) {
            std::string names;
            for (const std::string& name : option->get_snames()) names += " -s " + name;
            for (const std::string& name : option->get_lnames()) names += " -l " + name;
            const std::vector<std::string> words = words_of(*option);
            if (!words.empty())
                names += fmt::format(" -x -a '{}'", fmt::join(words, " "));
            else if (takes_value(*option))
                names += " -r";
            text += fmt::format("complete -c tangipaint -n '__fish_seen_subcommand_from {}'{} -d {}\n",
                                command->get_name(), names, in_quotes(option->get_description()));
        }
    }
    return text;
}

}  // namespace

std::vector<std::string> write_help_pages(const CLI::App& program, const std::filesystem::path& folder) {
    std::vector<std::string> files;
    const auto write = [&](const std::string& name, const std::string& text) {
        make_folder((folder / name).parent_path());
        write_text_file(folder / name, text);
        files.push_back((folder / name).string());
    };
    write("man/man1/tangipaint.1", man_page_of_program(program));
    for (const CLI::App* command : commands_of(program))
        write("man/man1/tangipaint-" + command->get_name() + ".1", man_page(*command));
    write("bash-completion/completions/tangipaint", bash_completion(program));
    write("zsh/site-functions/_tangipaint", zsh_completion(program));
    write("fish/vendor_completions.d/tangipaint.fish", fish_completion(program));
    return files;
}

}  // namespace tangi
