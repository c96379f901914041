// node rewrite_cdr.cjs FILE: takes messages apart with @foxglove/rosmsg2-serialization and writes them anew. The
// file holds a JSON list of {schema, cdr}, the bytes in hexadecimal; prints a list of {cdr, message}.
"use strict";
const fs = require("fs");
const { parse } = require("@foxglove/rosmsg");
const { MessageReader, MessageWriter } = require("@foxglove/rosmsg2-serialization");

const hex = (bytes) => Buffer.from(bytes.buffer, bytes.byteOffset, bytes.byteLength).toString("hex");

function plain(key, value) {
  if (typeof value === "bigint") return value.toString();
  return ArrayBuffer.isView(value) ? Array.from(value) : value;
}

const rewritten = JSON.parse(fs.readFileSync(process.argv[2], "utf8")).map(({ schema, cdr }) => {
  const definitions = parse(schema, { ros2: true });
  const message = new MessageReader(definitions).readMessage(Buffer.from(cdr, "hex"));
  return { cdr: hex(new MessageWriter(definitions).writeMessage(message)), message };
});
process.stdout.write(JSON.stringify(rewritten, plain) + "\n");
