// Saving a file so that power loss at any instant leaves the old version or the new one, whole.
//
// The content goes to a temporary file in the same directory, is flushed to the disk and takes the
// place of the old file by one rename. The version before stays beside it as "<name>.bak". A
// refusal (no space, no permission) leaves the old file as it was.
#pragma once

#include <filesystem>
#include <string_view>

#include "config/error.h"

namespace cnc::config {

/// Replaces `path`, or creates it. A symbolic link is followed and stays a link; the permissions of
/// the old file are kept. Blocks until the disk has the content: not for a real-time thread.
Result<void> write_file_atomically(const std::filesystem::path& path, std::string_view content);

/// The name under which write_file_atomically() keeps the version before.
[[nodiscard]] std::filesystem::path backup_path(const std::filesystem::path& path);

}  // namespace cnc::config
