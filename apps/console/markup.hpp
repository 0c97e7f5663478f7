#pragma once
// Markdown of the program's tables as other text: links and code in a line, nothing else.

#include <string>
#include <string_view>

namespace hertzline::app {

/// The text without its marks: "as a record does" of "[as a record does](#a-recorded-drive)".
std::string plain_text(std::string_view markdown);

/// The text with everything escaped that roff, the language of manual pages, would take for a command.
std::string roff_text(std::string_view text);

/// The text in lines of roff, code in bold.
std::string roff_paragraph(std::string_view markdown);

}  // namespace hertzline::app
