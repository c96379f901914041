#include <cctype>
#include <stdexcept>

#include "host_tools/recording/schema/message_types.h"

namespace stilt::schema {
namespace {

/// Words and signs of IDL, without comments and annotations.
class Tokens {
 public:
  explicit Tokens(std::string_view text) : text_(text) { advance(); }

  [[nodiscard]] const std::string& peek() const { return token_; }
  [[nodiscard]] bool at_end() const { return token_.empty(); }
  std::string take() {
    std::string token = token_;
    advance();
    return token;
  }
  bool take_if(std::string_view wanted) {
    if (token_ != wanted) return false;
    advance();
    return true;
  }
  void expect(std::string_view wanted) {
    if (!take_if(wanted)) {
      throw std::runtime_error("IDL: \"" + std::string(wanted) + "\" is expected where \"" + token_ +
                               "\" is");
    }
  }

 private:
  [[nodiscard]] static bool in_word(char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
  }

  void skip_blanks() {
    while (at_ < text_.size()) {
      if (std::isspace(static_cast<unsigned char>(text_[at_])) != 0) {
        ++at_;
      } else if (text_.substr(at_, 2) == "//") {
        at_ = std::min(text_.find('\n', at_), text_.size());
      } else if (text_.substr(at_, 2) == "/*") {
        at_ = std::min(text_.find("*/", at_), text_.size() - 2) + 2;
      } else if (text_[at_] == '@') {
        ++at_;
        while (at_ < text_.size() && in_word(text_[at_])) ++at_;
      } else {
        return;
      }
    }
  }

  void advance() {
    skip_blanks();
    const std::size_t start = at_;
    while (at_ < text_.size() && (in_word(text_[at_]) || text_.substr(at_, 2) == "::"))
      at_ += text_[at_] == ':' ? 2 : 1;
    if (at_ == start && at_ < text_.size()) ++at_;
    token_ = text_.substr(start, at_ - start);
  }

  std::string_view text_;
  std::size_t at_ = 0;
  std::string token_;
};

/// "pkg::msg::dds_::Type_" -> "pkg/msg/Type".
std::string ros_name(const std::string& scoped) {
  std::string name;
  for (std::size_t at = 0; at <= scoped.size();) {
    const std::size_t end = std::min(scoped.find("::", at), scoped.size());
    const std::string part = scoped.substr(at, end - at);
    if (part != "dds_") name += (name.empty() ? "" : "/") + part;
    at = end + 2;
  }
  if (name.ends_with('_')) name.pop_back();
  return name;
}

class Parser {
 public:
  explicit Parser(std::string_view idl) : tokens_(idl) {}

  MessageTypes parse() {
    while (!tokens_.at_end()) definition("");
    return std::move(types_);
  }

 private:
  void definition(const std::string& scope) {
    const std::string kind = tokens_.take();
    const std::string name = tokens_.take();
    tokens_.expect("{");
    if (kind == "module") {
      while (tokens_.peek() != "}") definition(scope + name + "::");
    } else if (kind == "struct") {
      structure(scope, name);
    } else {
      throw std::runtime_error("IDL: \"" + kind + "\" is not known; module and struct are");
    }
    tokens_.expect("}");
    tokens_.expect(";");
  }

  void structure(const std::string& scope, const std::string& name) {
    std::vector<Field>& fields = types_[ros_name(scope + name)];
    while (tokens_.peek() != "}") fields.push_back(field(scope));
  }

  Field field(const std::string& scope) {
    Field field;
    if (tokens_.take_if("sequence")) {
      tokens_.expect("<");
      field.type = type(scope);
      field.shape = Shape::sequence;
      tokens_.expect(">");
    } else {
      field.type = type(scope);
    }
    field.name = tokens_.take();
    if (tokens_.take_if("[")) {
      if (field.shape == Shape::sequence)
        throw std::runtime_error("IDL: " + field.name + ": an array of sequences");
      field.shape = Shape::array;
      field.count = std::stoul(tokens_.take());
      tokens_.expect("]");
    }
    tokens_.expect(";");
    return field;
  }

  std::string type(const std::string& scope) {
    const bool is_unsigned = tokens_.take_if("unsigned");
    const std::string word = tokens_.take();
    const std::string sign = is_unsigned ? "u" : "";
    if (word == "long") return sign + (tokens_.take_if("long") ? "int64" : "int32");
    if (word == "short") return sign + "int16";
    if (word == "octet") return "uint8";
    if (word == "boolean") return "bool";
    if (word == "float") return "float32";
    if (word == "double") return "float64";
    if (word == "string") return "string";
    const std::string name = ros_name(word.find("::") == std::string::npos ? scope + word : word);
    if (!types_.contains(name)) throw std::runtime_error("IDL: the type " + word + " is not known");
    return name;
  }

  Tokens tokens_;
  MessageTypes types_;
};

}  // namespace

MessageTypes parse_idl(std::string_view idl) { return Parser(idl).parse(); }

}  // namespace stilt::schema
