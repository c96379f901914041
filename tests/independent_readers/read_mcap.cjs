// node read_mcap.cjs FILE [index]: what @mcap/core finds in a record, as JSON. Reads from front to end, as one
// must when recording was cut off; with "index" by the index at the end, which a whole file has.
"use strict";
const fs = require("fs");
const { McapIndexedReader, McapStreamReader } = require("@mcap/core");
const { loadDecompressHandlers } = require("@mcap/support");

const crcOf = (data) => require("@foxglove/crc").crc32(data);

function describeMessage(message) {
  return {
    channel: message.channelId,
    sequence: message.sequence,
    log_time_ns: message.logTime.toString(),
    publish_time_ns: message.publishTime.toString(),
    size: message.data.byteLength,
    crc: crcOf(message.data),
  };
}

function describeChannel(channel, schema) {
  return {
    id: channel.id,
    topic: channel.topic,
    encoding: channel.messageEncoding,
    metadata: Object.fromEntries(channel.metadata),
    schema: schema?.name,
    schema_encoding: schema?.encoding,
    schema_text: schema && Buffer.from(schema.data).toString(),
  };
}

function describeAttachment(attachment) {
  return {
    name: attachment.name,
    media_type: attachment.mediaType,
    text: Buffer.from(attachment.data).toString(),
  };
}

/** A group of records of one kind in the summary. */
function describeGroup(offset) {
  return { op: offset.groupOpcode, start: Number(offset.groupStart), length: Number(offset.groupLength) };
}

function readFromFront(bytes, decompressHandlers) {
  const found = { channels: [], messages: [], attachments: [], metadata: [], groups: [], ended: false, chunks: 0 };
  const schemas = new Map();
  const reader = new McapStreamReader({ validateCrcs: true, decompressHandlers, includeChunks: true });
  reader.append(bytes);
  for (let record; (record = reader.nextRecord()); ) {
    if (record.type === "Schema") schemas.set(record.id, record);
    if (record.type === "Chunk") found.chunks++;
    if (record.type === "Channel" && !found.channels.some((known) => known.id === record.id)) {
      found.channels.push(describeChannel(record, schemas.get(record.schemaId)));
    }
    if (record.type === "Message") found.messages.push(describeMessage(record));
    if (record.type === "Attachment") found.attachments.push(describeAttachment(record));
    if (record.type === "Metadata") found.metadata.push([record.name, Object.fromEntries(record.metadata)]);
    if (record.type === "SummaryOffset") found.groups.push(describeGroup(record));
    if (record.type === "Footer") found.ended = true;
  }
  return found;
}

function describeStatistics(statistics) {
  return {
    messages: Number(statistics.messageCount),
    schemas: statistics.schemaCount,
    channels: statistics.channelCount,
    attachments: statistics.attachmentCount,
    metadata: statistics.metadataCount,
    chunks: statistics.chunkCount,
    times_ns: [Number(statistics.messageStartTime), Number(statistics.messageEndTime)],
    messages_of_channel: [...statistics.channelMessageCounts].map(([id, count]) => [id, Number(count)]),
  };
}

async function readByIndex(bytes, decompressHandlers) {
  const readable = {
    size: async () => BigInt(bytes.length),
    read: async (offset, size) => bytes.subarray(Number(offset), Number(offset + size)),
  };
  const reader = await McapIndexedReader.Initialize({ readable, decompressHandlers });
  const found = { channels: [], messages: [], attachments: [], metadata: [], chunks: reader.chunkIndexes.length };
  for (const channel of reader.channelsById.values()) {
    found.channels.push(describeChannel(channel, reader.schemasById.get(channel.schemaId)));
  }
  for await (const message of reader.readMessages({ validateCrcs: true })) {
    found.messages.push(describeMessage(message));
  }
  for await (const attachment of reader.readAttachments({ validateCrcs: true })) {
    found.attachments.push(describeAttachment(attachment));
  }
  for await (const metadata of reader.readMetadata()) {
    found.metadata.push([metadata.name, Object.fromEntries(metadata.metadata)]);
  }
  found.statistics = describeStatistics(reader.statistics);
  found.chunk_times_ns = reader.chunkIndexes.map((chunk) => [Number(chunk.messageStartTime), Number(chunk.messageEndTime)]);
  return found;
}

async function main() {
  const bytes = new Uint8Array(fs.readFileSync(process.argv[2]));
  const handlers = await loadDecompressHandlers();
  const found = process.argv[3] === "index" ? await readByIndex(bytes, handlers) : readFromFront(bytes, handlers);
  process.stdout.write(JSON.stringify(found) + "\n");
}

main().catch((error) => {
  process.stderr.write(`${error.stack}\n`);
  process.exit(1);
});
