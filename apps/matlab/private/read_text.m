function text = read_text(file)
%READ_TEXT  A file of UTF-8; '' where there is none.
handle = fopen(file, 'r');
if handle < 0
    text = '';
    return
end
text = native2unicode(fread(handle, Inf, '*uint8')', 'UTF-8');
fclose(handle);
end
