// Prints docs/settings.md: settings_page > docs/settings.md
#include <fmt/format.h>

#include "config/schema.h"

int main() { fmt::print("{}", cnc::config::settings_as_markdown()); }
