// The library may not include the project's error table, so a test compares.
#include <catch2/catch.hpp>

#include "api/src/local_error.h"
#include "config/error.h"

TEST_CASE("The library's own errors are rows of the project's error table", "[api]") {
  REQUIRE_FALSE(cnc::api::local_errors().empty());
  for (const cnc::api::LocalError& local : cnc::api::local_errors()) {
    const cnc::ErrorInfo& row = cnc::error_info(static_cast<cnc::ErrorCode>(local.code));
    CHECK(static_cast<std::uint32_t>(row.code) == local.code);
    CHECK(row.name == local.name);
    CHECK(row.check == local.check);
  }
}
