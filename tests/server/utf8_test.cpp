// Text of any encoding on its way into the API (LNG-10).
#include "server/rpc/utf8.h"

#include <catch2/catch.hpp>

using cnc::server::rpc::valid_utf8;

TEST_CASE("Valid UTF-8 passes unchanged", "[LNG-10]") {
  // The first and last code points of each length (RFC 3629, section 3).
  const std::string text =
      GENERATE(as<std::string>{}, "", "G1 X2", "\x7f", "\u0080\u07ff", "\u0800\ud7ff\ue000\uffff",
               "\U00010000\U0010ffff", "gefräst µm ½");
  CHECK(valid_utf8(text) == text);
}

TEST_CASE("Every byte that is no part of UTF-8 becomes one U+FFFD", "[LNG-10]") {
  struct Row {
    const char* bytes;
    const char* text;
  };
  const auto [bytes, text] = GENERATE(values<Row>({
      {"fr\xe4se", "fr\uFFFDse"},                        // ISO-8859-1
      {"\xc3", "\uFFFD"},                                // ends in the middle
      {"\xe2\x82x", "\uFFFD\uFFFDx"},                    // broken off
      {"\x80", "\uFFFD"},                                // continuation without a beginning
      {"\xc0\xaf", "\uFFFD\uFFFD"},                      // overlong '/'
      {"\xe0\x80\xaf", "\uFFFD\uFFFD\uFFFD"},            // overlong '/'
      {"\xed\xa0\x80", "\uFFFD\uFFFD\uFFFD"},            // a surrogate
      {"\xf4\x90\x80\x80", "\uFFFD\uFFFD\uFFFD\uFFFD"},  // beyond U+10FFFF
      {"\xff", "\uFFFD"},
  }));
  CHECK(valid_utf8(bytes) == text);
}
