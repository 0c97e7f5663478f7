function words = vary_words(vary)
%VARY_WORDS  {KEY, VALUES, ...} as words of the command line. VALUES are numbers, a cell of texts, or a range as text.
if ~iscell(vary) || mod(numel(vary), 2)
    error('hertzline:wrongUse', 'vary: found a %s of %d entries, allowed: a cell {KEY, VALUES, ...}', class(vary), numel(vary));
end
words = {};
for k = 1:2:numel(vary)
    key = program_key(vary{k});
    values = vary{k + 1};
    if isa(values, 'string') && isscalar(values)
        values = char(values);
    end
    texts = texts_of(key, values);
    if ~ischar(values) && ~isnumeric(values)
        texts = cellfun(@(text) entry_of(key, text), texts, 'UniformOutput', false);
    end
    if isempty(texts)
        error('hertzline:wrongUse', 'vary %s: found no values, allowed: at least one', key);
    end
    words = [words, {'--vary', [key '=' strjoin(texts, ',')]}]; %#ok<AGROW>
    if numel(words{end}) > 100000  % the system takes words of 128 KiB
        error('hertzline:wrongUse', 'vary %s: found %d values, allowed: as many as "points"', key, numel(texts));
    end
end
end

function text = entry_of(key, text)
% Quoted where the program would take it for something else: a list, a range, a text in quotes.
if isempty(text) || any(ismember(text, ',"''[]\')) || any(text < ' ' | text > '~') || ~isempty(strfind(text, '..')) %#ok<STREMP>
    text = toml_value(key, text, 0);
end
end
