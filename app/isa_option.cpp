#include "app/isa_option.h"

#include <CLI/CLI.hpp>

#include "core/geometry/instruction_set.h"

namespace talbot {

void add_isa_option(CLI::App& app) {
    app.add_option_function<std::string>(
           "--isa",
           [](const std::string& name) {
               if (use_instruction_set(name)) return;
               std::string known;
               for (const std::string& set : instruction_sets_here())
                   known += (known.empty() ? "" : ", ") + set;
               throw CLI::ValidationError("--isa", "'" + name +
                                                       "' is no instruction set of this machine; "
                                                       "it has " +
                                                       known);
           },
           "trace rays with this instruction set, not the machine's best; changes no byte")
        ->type_name("NAME");
}

}  // namespace talbot
