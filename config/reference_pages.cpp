// Prints a page of the reference that is written from a table:
//   reference_pages settings > docs/settings.md
//   reference_pages errors > docs/errors.md
#include <cstdlib>
#include <fmt/format.h>
#include <string_view>

#include "config/error.h"
#include "config/schema.h"

int main(int argc, char** argv) {
  const std::string_view page = argc == 2 ? argv[1] : "";
  if (page == "settings") {
    fmt::print("{}", cnc::config::settings_as_markdown());
  } else if (page == "errors") {
    fmt::print("{}", cnc::errors_as_markdown());
  } else {
    fmt::print(stderr, "usage: reference_pages settings|errors\n");
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
