function text = toml_value(key, value, depth)
%TOML_VALUE  A value as TOML has it. DEPTH is 0 for a number or text, 1 for a list, 2 for a list of lists, whose rows are lists.
if isa(value, 'string')
    value = cellstr(value);
    if depth == 0 && numel(value) == 1
        value = value{1};
    end
end
if ischar(value)
    text = ['"' escaped(value) '"'];
    if depth == 1
        text = ['[' text ']'];
    end
elseif iscell(value)
    entries = cellfun(@(entry) toml_value(key, entry, max(depth - 1, 0)), value(:)', 'UniformOutput', false);
    text = ['[' strjoin(entries, ', ') ']'];
elseif islogical(value) && isscalar(value)
    words = {'false', 'true'};
    text = words{value + 1};
elseif ~isnumeric(value) || ~isreal(value)
    error('hertzline:wrongUse', '%s: found a %s, allowed: a number, a text, an array or a cell of them', key, class(value));
elseif depth == 2
    rows = cellfun(@(row) toml_value(key, row, 1), num2cell(value, 2), 'UniformOutput', false);
    text = ['[' strjoin(rows', ', ') ']'];
elseif depth == 1 || numel(value) ~= 1
    text = lower(sprintf('%.17g, ', double(value)));  % TOML has nan and inf
    text = ['[' text(1 : end - 2) ']'];
else
    text = number_text(value);
end
end

function text = escaped(text)
% TOML of the program is ASCII.
codes = [2^24 2^16 2^8 1] * reshape(double(unicode2native(text, 'UTF-32BE')), 4, []);
parts = num2cell(char(codes));
for k = find(codes < 32 | codes > 126 | codes == '"' | codes == '\')
    parts{k} = sprintf('\\U%08X', codes(k));
end
text = [parts{:}];
end
