// node foxglove_client.cjs URL SUBPROTOCOL [--origin=SITE] TOPIC...: connects as a viewer does, as a page of SITE or as
// a program, with @foxglove/ws-protocol, takes the first message of each topic apart, and prints {protocol, info,
// channels, messages}.
"use strict";
const { WebSocket } = require("ws");
const { FoxgloveClient } = require("@foxglove/ws-protocol");
const { parse } = require("@foxglove/rosmsg");
const { MessageReader } = require("@foxglove/rosmsg2-serialization");

const [url, subprotocol, ...rest] = process.argv.slice(2);
const topics = rest.filter((word) => !word.startsWith("--"));
const origin = rest.find((word) => word.startsWith("--origin="))?.slice("--origin=".length);
const socket = new WebSocket(url, [subprotocol], { origin });
const client = new FoxgloveClient({ ws: socket });
const found = { info: null, channels: [], messages: {} };
const channelOf = new Map();  // by subscription

function plain(key, value) {
  if (typeof value === "bigint") return value.toString();
  return ArrayBuffer.isView(value) ? Array.from(value) : value;
}

function fail(what) {
  process.stderr.write(`${what}\n`);
  process.exit(1);
}

client.on("error", (error) => fail(`error: ${error.message ?? error}`));
client.on("close", () => fail("the server has closed the connection"));
client.on("status", (status) => fail(`status: ${status.message}`));
client.on("serverInfo", (info) => { found.info = info; });
client.on("advertise", (channels) => {
  found.channels.push(...channels);
  for (const channel of channels) {
    if (topics.includes(channel.topic)) channelOf.set(client.subscribe(channel.id), channel);
  }
});
client.on("message", ({ subscriptionId, timestamp, data }) => {
  const channel = channelOf.get(subscriptionId);
  if (found.messages[channel.topic]) return;
  const message = new MessageReader(parse(channel.schema, { ros2: true })).readMessage(data);
  found.messages[channel.topic] = { timestamp, message };
  client.unsubscribe(subscriptionId);
  if (Object.keys(found.messages).length < topics.length) return;
  found.protocol = socket.protocol;
  process.stdout.write(JSON.stringify(found, plain) + "\n", () => process.exit(0));
});
setTimeout(() => fail(`not everything came: ${JSON.stringify(found.messages, plain)}`), 60000);
