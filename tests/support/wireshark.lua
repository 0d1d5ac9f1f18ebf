-- What the dissector uses of Wireshark, for tests without it. `dissect(bytes)` returns what stands
-- in the tree of a datagram: filters and values by turns, in the order in which they were added.

local protocols, shown = {}, {}

local Range = {}
Range.__index = Range
Range.__call = function(range, offset, length)
    offset = offset or 0
    length = length or #range.data - offset
    assert(offset >= 0 and length >= 0 and offset + length <= #range.data, "out of bounds")
    return setmetatable({ data = range.data:sub(offset + 1, offset + length) }, Range)
end

local UInt64 = {}
UInt64.__index = UInt64
function UInt64:tonumber() return self.whole >= 0 and self.whole + 0.0 or self.whole + 2.0 ^ 64 end
function UInt64:lshift(bits) return setmetatable({ whole = self.whole << bits }, UInt64) end
function UInt64:rshift(bits) return setmetatable({ whole = self.whole >> bits }, UInt64) end
function UInt64:text() return string.format("%u", self.whole) end

function Range:len() return #self.data end
Range.reported_len = Range.len
function Range:uint() return string.unpack(">I" .. #self.data, self.data) end
function Range:le_uint() return string.unpack("<I" .. #self.data, self.data) end
function Range:le_int() return string.unpack("<i" .. #self.data, self.data) end
function Range:le_float() return string.unpack(#self.data == 4 and "<f" or "<d", self.data) end
function Range:le_uint64() return setmetatable({ whole = string.unpack("<i8", self.data) }, UInt64) end
function Range:le_int64() return { tonumber = function() return self:le_int() + 0.0 end } end
function Range:raw() return self.data end

local function decoded(field, range)
    if field.kind:find("^uint") then
        local whole = string.unpack("<I" .. #range.data, range.data)
        local low = field.mask and field.mask & -field.mask or 1
        return field.mask and (whole & field.mask) // low or string.format("%u", whole)
    elseif field.kind:find("^int") then
        return range:le_int()
    elseif field.kind == "float" or field.kind == "double" then
        return range:le_float()
    end
    return (range.data:gsub(".", function(byte) return string.format("%02x", byte:byte()) end))
end

local Tree = {}
Tree.__index = Tree
function Tree:add(field, range, value)
    if field.filter then
        if value == nil then value = decoded(field, range) end
        if type(value) == "table" then value = value:text() end
        shown[#shown + 1], shown[#shown + 2] = field.filter, value
    end
    return setmetatable({}, Tree)
end
Tree.add_le = Tree.add
function Tree:add_proto_expert_info(note, text)
    shown[#shown + 1], shown[#shown + 2] = note.filter, text
end
function Tree:append_text() return self end
Tree.set_text, Tree.set_len, Tree.set_generated = Tree.append_text, Tree.append_text, Tree.append_text

local function anything() return setmetatable({}, { __index = function() return 0 end }) end

ProtoField = setmetatable({}, {
    __index = function(_, kind)
        return function(filter, _, _, _, mask)
            return { kind = kind, filter = filter, mask = mask and math.tointeger(mask) }
        end
    end,
})
ProtoExpert = { new = function(filter) return { filter = filter } end }
Pref = { string = function() return "" end }
base, expert = anything(), { group = anything(), severity = anything() }
DissectorTable = { get = function() return { add = function() end } end }
function Proto(name)
    protocols[name] = { prefs = {} }
    return protocols[name]
end

function dissect(bytes)
    shown = {}
    local packet = { cols = {}, number = 1, visited = false }
    protocols.jaus.dissector(setmetatable({ data = bytes }, Range), packet, setmetatable({}, Tree))
    return shown
end
